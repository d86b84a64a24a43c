; Messages and ordered errors in the stream.
#MSG ["begin of program"]
P1 = 2.6
G00 X[P1]
#MSG SYN HMI ["X %f, about %d of %s, 100 %%", P1, P1, "parts"]
#ERROR [ID=100 RC=0 PV1=P1 PV2=3]
#FLUSH
#FLUSH WAIT
X0
#ERROR [ID=101]
M30
