"""Many offline runs of one machine with other parameters: what varies, what is measured, where it is computed.

A `Plan` says which variants there are, `variant_run.py` computes one, `pool.py` many on Dask, `journal.py` keeps what
is finished, `table.py` and `page.py` show all of it. Only `pool.py` knows Dask, only `optimiser.py` knows Optuna.
"""
