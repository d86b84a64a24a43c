"""A tool changer: M6 of a program waits until this program has done it. `graph` as argument: with the ROS graph."""

import sys

from cnc_ptp.client import HandshakeRequest, Machine

PROGRAM = """%part
N10 T2 M6
N20 G0 X10 Y10
N30 M3 S2000
N40 G1 X60 F3000
N50 M5
N60 M30
"""

with (Machine.start if "graph" in sys.argv else Machine.offline)("config/mill.yaml") as m:

    def on_request(request: HandshakeRequest) -> bool:
        """True acknowledges the request."""
        print(f"{m.time:6.2f} s  line {request.line}: {request.kind}{request.number} {request.spindle}")
        if request.kind == "M" and request.number == 6:
            m.run_for(1.5)  # the arm changes the tool, the program waits
        return True

    m.plc.on_handshake(on_request)
    job = m.channel.run("part.nc", text=PROGRAM).wait(timeout=60.0)
    print(f"{m.time:6.2f} s  {job}, X{m.x.state.set_position:g}")
