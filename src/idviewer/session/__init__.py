"""State, pipeline, runner and session: contents of the display and their computation, without any window."""

from idviewer.session.carried_query import is_complete
from idviewer.session.eigenpair_source import EigenpairSource
from idviewer.session.picking import FramePicker, Probe, Target
from idviewer.session.pipeline import Pipeline
from idviewer.session.planes import PlaneCommands, active_plane, axis_of
from idviewer.session.previews import describe_preview
from idviewer.session.repair_desk import RepairDesk
from idviewer.session.run_to_end import run_to_end
from idviewer.session.runner import Runner, Work
from idviewer.session.session import Session
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import (
    MAX_ISOLINES,
    Display,
    DropRequest,
    Examined,
    ExamineRequest,
    Failure,
    Finished,
    Foretold,
    Frame,
    FrameRequest,
    Opened,
    OpenRequest,
    Point,
    Progress,
    Quantity,
    Query,
    Ready,
    Repaired,
    RepairRequest,
    Request,
    Result,
    Snapshot,
    State,
    default_plane,
)

__all__ = [
    "MAX_ISOLINES",
    "Display",
    "DropRequest",
    "EigenpairSource",
    "ExamineRequest",
    "Examined",
    "Failure",
    "Finished",
    "Foretold",
    "Frame",
    "FramePicker",
    "FrameRequest",
    "OpenRequest",
    "Opened",
    "Pipeline",
    "PlaneCommands",
    "Point",
    "Probe",
    "Progress",
    "Quantity",
    "Query",
    "Ready",
    "RepairDesk",
    "RepairRequest",
    "Repaired",
    "Request",
    "Result",
    "Runner",
    "Session",
    "Snapshot",
    "SpectrumCache",
    "State",
    "Target",
    "Work",
    "active_plane",
    "axis_of",
    "default_plane",
    "describe_preview",
    "is_complete",
    "run_to_end",
]
