"""The studio: a page in the browser where a linkage is shaped and seen to move (extra `[studio]`).

It solves nothing itself: the description goes to the linkage, the linkage gives its motion, and the page
shows what report and figures tell.
"""
