O0184 (rigid tapping in pecks of 4 mm; --set 5200.5=1 takes the tap back to R each time)
G98
G0 X50 Z0
M29 S1000
G84 Z-50 Q4.0 P3000 F2000
G80
M30
