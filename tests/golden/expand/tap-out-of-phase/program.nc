G98 G0 X20 Z5
M29 S1200
G84 Z-10 F900 K198
G0 Z5 (this would tear the tap off)
M30
