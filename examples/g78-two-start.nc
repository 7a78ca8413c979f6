O0278 (M30x4 P2: two starts, flanks in turn, run-in and run-out)
G50 X100 Z50
M3 S200
G00 X44 Z10
G78 P010460 Q0.08 R0.05 L2 D1 (one finishing pass, left and right flank in turn)
G78 X27.546 Z-30 P1.227 Q0.35 F4 J1.5 K1.5 E2
G00 X100 Z50
M05
M30
