"""NC language: text -> parser (lexer) -> blocks -> interpreter (modal state) -> canonical blocks.

Units at this boundary: the program has mm, mm/min, rpm and seconds; the canonical stream has mm, mm/s, rpm and seconds.
"""
