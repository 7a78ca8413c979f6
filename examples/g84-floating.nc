O0084 (ordinary tapping: M8x1.25, 20 mm deep, a floating holder)
G98
G0 X0 Z10
M3 S400
G84 Z-20 R-5 P200 F500
G80
M5
M30
