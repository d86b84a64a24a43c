"""Spinning nodes in a test until something has come."""


def spin_until(executor, condition):
    for _ in range(3000):
        if condition():
            return
        executor.spin_once(timeout_sec=0.01)
    raise AssertionError("nothing more comes")
