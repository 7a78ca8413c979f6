O0084 (rigid tapping, the standard hole: 25 turns in, 3 s, 25 turns out)
G98
G0 X50 Z0
M29 S1000 (rigid mode: the spindle stands and waits in position mode)
G84 Z-50 P3000 F2000 (lead 2 mm = F / S)
G80
M30
