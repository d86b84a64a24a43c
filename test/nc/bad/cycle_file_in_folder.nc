; P-ERR-21592 cycle_file_in_folder.nc line 2 column 1 'L CYCLE [NAME=/etc/passwd]': /ETC/PASSWD: programs are called by their name alone, they are looked for in the search folders
L CYCLE [NAME=/etc/passwd]
M30
