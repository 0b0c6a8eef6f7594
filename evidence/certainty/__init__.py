"""Whether anything is lost: circuits, change points, and which loops move, over families by the thousand."""
