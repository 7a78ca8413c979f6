O0078 (the printed G78 example, made to run: spindle on, lead 3 mm)
M3 S10
G00 X80 Z10
G78 P020045 Q0.15 R0.5 (two finishing passes, down the centre, 45 degrees)
G78 X60 Z-60 P3 Q1.8 F3 J1.5 K2
G00 X80 Z10
M05
M30
