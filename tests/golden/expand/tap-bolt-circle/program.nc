O0284 (four M6 on a circle of 40 mm by the C axis, with clamp M10 and unclamp M11)
G98
G0 X40 Z5 C0
M29 S600
G84 C0 Z-12 R-3 F600 M10 (R 3 mm below Z5; lead 1 mm)
C90
C180
C270
G80
M30
