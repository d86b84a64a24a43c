"""The web face of a machine: the process `web` serves pages, and is a client of the machine (docs/web.md).

server.py       routes and static files
hub.py          the machine and its sessions: what goes to all pages
session.py      one page: its messages, its rights, its subscriptions
face.py         what pages see of a machine; machine_face.py offline, live_face.py the graph
protocol.py     messages between page and server
"""
