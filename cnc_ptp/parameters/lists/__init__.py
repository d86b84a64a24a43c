"""The vendor's ASCII lists: a folder of lists -> machine file, and back. Pure; docs/lists.md says what a list is.

text.py       bytes of a file -> its text: encoding, characters
lines.py      text -> lines: name, rest, comments, sections
kinds.py      kinds of lists: names of files, what a list looks like
names.py      name of a line -> declaration and indexes; old spellings, missing prefixes
values.py     value of a line -> YAML, and back
startup.py    the start-up list: which file is which list
folder.py     the lists of a folder, each with its kind
units.py      the axis or channel of each list, and its name as a node
importing.py  lists -> machine file with a report
machine_text.py, marks.py  the machine file: one line for each line of a list, with its place; how it keeps the rest
commented.py  machine file -> sections with comments
exporting.py  machine file -> lists
report.py     what was read, corrected, defaulted, unknown
problems.py   what refuses an import or export: all problems at once
"""
