"""The web face of a machine: the process `web` serves pages, and is a client of the machine (docs/web.md).

server.py       routes and static files
hub.py          the machine and its sessions: what goes to all pages
view.py         what pages know of a machine: one for all of a machine that runs, one for each page of a recording
session.py      one page: its messages, its rights, its subscriptions
faces/          what pages see of a machine: machine_face.py offline, live_face.py the graph, recorded_face.py
protocol.py     messages between page and server
"""
