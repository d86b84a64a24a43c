; P-ERR-21671 thread_lead_ends.nc line 3 column 1 'G35 Z48 K1.5 F0.1': the lead falls from 1.5 mm to 0 within 11.25 mm at 0.1 mm per revolution; the thread has 48 mm
M03 S400
G35 Z48 K1.5 F0.1
M30
