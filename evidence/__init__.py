"""How far Sevenbar can be relied on: how exact, how fast, what hard use did, a page of docs each."""

from pathlib import Path

#: The folder of the repository.
ROOT = Path(__file__).parent.parent
