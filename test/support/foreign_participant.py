"""A participant that does not belong to a machine: looks for its topics and tries to command its axis x.

`python foreign_participant.py SECONDS`, in any network namespace and environment; prints what it has found as JSON as
soon as everything was seen and done, at the latest after SECONDS.
"""

import json
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from cnc_ptp import msg, srv
from cnc_ptp.nodes.topics import BLOCKS, PLC_INPUT

OWN = {"/rosout", "/parameter_events"}


def main(seconds):
    rclpy.init()
    node = Node("foreign", enable_rosout=False)
    found = {"topics": [], "setpoints": 0, "readers": 0, "accepted": None}

    velocity = [0.0]

    def count(block):
        found["setpoints"] += block.count
        velocity[0] = block.set_velocity[-1]

    node.create_subscription(msg.AxisBlock, "x/block", count, BLOCKS)
    jog = node.create_publisher(msg.Jog, "x/jog", PLC_INPUT)
    mover = node.create_client(srv.MoveAbsolute, "x/move_absolute")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    deadline, answer, sequence = time.monotonic() + seconds, None, 0
    while time.monotonic() < deadline and not (found["setpoints"] and found["accepted"] is not None):
        sequence += 1
        jog.publish(msg.Jog(sequence=sequence, velocity=5.0, valid=True))
        if answer is None and mover.service_is_ready():
            answer = mover.call_async(srv.MoveAbsolute.Request(target=7.0, velocity=50.0))
        executor.spin_once(timeout_sec=0.1)
        if answer is not None and answer.done():
            found["accepted"] = answer.result().accepted
    found["readers"] = jog.get_subscription_count()
    jog.publish(msg.Jog(sequence=sequence + 1, velocity=0.0, valid=True))
    deadline = time.monotonic() + seconds
    begin = found["setpoints"]
    while begin and time.monotonic() < deadline and (velocity[0] or found["setpoints"] < begin + 500):
        executor.spin_once(timeout_sec=0.1)  # what it has moved comes to rest
    mine = {"/x/block", "/x/jog"} | OWN
    found["topics"] = sorted({name for name, _ in node.get_topic_names_and_types()} - mine)
    print(json.dumps(found))


if __name__ == "__main__":
    main(float(sys.argv[1]))
