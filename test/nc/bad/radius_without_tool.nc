; P-ERR-21683 radius_without_tool.nc line 4 column 1 'G41 G01 X0 Y0': G41 without a tool: no compensation data with a radius are active
; tools milling
G00 X-10 F600
G41 G01 X0 Y0
X10
M30
