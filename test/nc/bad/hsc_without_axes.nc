; P-ERR-21629 hsc_without_axes.nc line 3 column 1 '#HSC ON [BSPLINE PATH_DEV=0.01]': #HSC smooths the path of axes, but the channel has none
; machine / S
#HSC ON [BSPLINE PATH_DEV=0.01]
M30
