(work coordinates move, machine coordinates tell the truth)
G0 X20 Z10
G50 X100 Z50
G0 X98 Z49
G0 U-2 W-1
G53 G0 X0 Z0
M2
