%
o12(lower case, no spaces, crlf)
n10g0x10z5
/n20g1x99f100
n30 g1 z-5 f100; (end of block)
m30
%
never read
