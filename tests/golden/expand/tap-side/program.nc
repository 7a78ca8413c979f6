O0088 (a side tap M8 from X60 to X30; R and Q on the radius)
G98
G0 X60 Z-20
M29 S500
G88 X30 R-2 Q5 D0.5 F625 (lead 1.25 mm)
G80
M30
