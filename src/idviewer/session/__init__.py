"""What is shown and how it is computed: state, pipeline, runner and session, without any window."""

from idviewer.session.session import Session
from idviewer.session.state import Display, Frame, Query, State

__all__ = ["Display", "Frame", "Query", "Session", "State"]
