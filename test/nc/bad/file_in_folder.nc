; P-ERR-21592 file_in_folder.nc line 2 column 1 'L ../drill.nc': ../DRILL.NC: programs are called by their name alone, they are looked for in the search folders
L ../drill.nc
M30
