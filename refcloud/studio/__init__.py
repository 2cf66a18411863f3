"""The studio: a page in the browser with a slider for every parameter."""

from refcloud.studio.box import Box, box_picture
from refcloud.studio.choices import find_setup, setups
from refcloud.studio.jobs import Jobs
from refcloud.studio.server import Studio

__all__ = ["Box", "Jobs", "Studio", "box_picture", "find_setup", "setups"]
