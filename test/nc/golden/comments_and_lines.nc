; Comments of all kinds, continued lines, labels and numbers, upper and lower case, texts with signs of comments.
n10 g00 x1 ( within ( nested ) a line ) y2 ; to the end
#COMMENT BEGIN
G00 X1000
$IF
#COMMENT END
N20 X[1 + \
 2] \
 Y3
p1=4 v.p.text = "a ; (b) $IF #"
X[LEN[v.P.Text]]   ; 13 characters
/ N30 X5
/2 X6
N40 (nothing)

X=p1(,)Y=P1
m30
