(clip: A X20, D X0, peck 6 on the radius, e 5; then columns with a remainder and a relief)
G0 X40 Z0
G75 R5
G75 X0 P120000 F100
G0 X50 Z-10
G75 R0.5
G75 X40 W-7 P60000 Q30000 R0.2 F80
M30
