"""Recordings: a directory that keeps what a tap saw, whatever happens to the recorder.

`docs/reference/recording.md` describes the files. `Recorder` writes, `read_recording` reads; both
may be at work at once.
"""
