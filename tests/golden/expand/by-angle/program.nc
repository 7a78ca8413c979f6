(DIALECT FANUC-A)
G98 M3 S600 F100
G0 X20 Z2
G1 Z0
X40 ,A135
G1 A180,R2.
(two lines, and a rounding where they meet)
X60 Z-30 A90
X80 A150 C1.
Z-60
M30
