"""Mined nets as the page shows them: runs, tokens, and the learned controller beside the PLC."""
