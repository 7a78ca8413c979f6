O0484 (a tap stopped in its hole; how it is brought out is in the README)
G98
G0 X0 Z5
M29 S600
G84 Z-30 R-3 Q6 D1 F900 (lead 1.5 mm; R 3 mm below Z5)
G80
M30
