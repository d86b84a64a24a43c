from cnc_ptp.client import Machine

with Machine.offline("config/mill.yaml") as m:
    m.x.move_absolute(100).wait()
    print(m.x.state.set_position)
