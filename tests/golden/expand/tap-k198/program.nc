(the tap stays in its hole, the coolant changes, and it goes on deeper)
G98 G0 X20 Z5
M29 S1200
G84 Z-10 R-3 F900 K198 M10
M9
G4 P250
G84 Z-16 P100
U-4 K3
G80 G0 Z20
M30
