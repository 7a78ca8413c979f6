O0384 (a left-hand tap: negative S; the lead by G99, retract twice as fast)
G99
G0 X0 Z5
M29 S-400
G84 Z-20 R-3 F1.5 J800 (J needs --set 5200.4=1 --set 5201.4=1)
G80
M30
