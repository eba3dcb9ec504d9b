"""Raw body: polygons as they were read, whether or not they make a mesh, and their repair by name."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from idviewer.core.errors import Part
from idviewer.core.shapes.diagnosis import Diagnosis, diagnosis_of
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.named_repairs import NAMED_REPAIRS, Surface, wall_record
from idviewer.core.shapes.repairs import NO_REPAIRS, RepairRecord, Repairs
from idviewer.core.steps import finish
from idviewer.core.validation.file_numbering import FileNumbering
from idviewer.core.validation.finding_kinds import COMPONENT_KINDS
from idviewer.core.validation.findings import Finding
from idviewer.core.validation.mesh_checks import validate, without_duplicates
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.repair_choices import ComponentChoice, RepairChoices
from idviewer.core.validation.validation_report import ValidationReport

Result = TypeVar("Result")
Steps = Generator[None, None, Result]
"""Long work, with checkpoints at which it may be left."""


@dataclass(frozen=True, eq=False)
class RawBody:
    """Polygons as they were read, which need not make a mesh.

    Attributes:
        polygons: nothing about them needs to be right.
        name: for titles.
        notes: of the file's reader, one sentence each.
        unit: of the coordinates; empty where it is not known.
        component: which of several components to take; None where there may be only one.
        parts: the shapes that the file knows by name, all of which are in it.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> body = RawBody(PolygonSoup.of(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2]]), "bag")
    >>> body.repaired(Repairs(fill_holes=3)).mesh
    Mesh('bag', 4 vertices, 4 faces)
    """

    polygons: PolygonSoup
    name: str = ""
    notes: tuple[str, ...] = ()
    unit: str = ""
    component: ComponentChoice | None = None
    parts: tuple[Part, ...] = ()

    @classmethod
    def of(cls, mesh: Mesh) -> RawBody:
        """The polygons of a mesh, which are all right. That faces cross is told anew, as long as they do."""
        crossing = mesh.self_intersections.finding.note if mesh.self_intersections else None
        notes = tuple(note for note in mesh.notes if note != crossing)
        return cls(PolygonSoup.of(mesh.vertices, mesh.faces), mesh.name, notes, mesh.unit)

    def repaired(self, repairs: Repairs = NO_REPAIRS) -> RepairOutcome:
        """Make the repairs, and then those that need no asking."""
        return finish(self.repair_steps(repairs))

    def meshes(self, repairs: Repairs, source: str) -> tuple[Mesh, ...]:
        """Make a mesh of each component, that of the largest volume first.

        Args:
            repairs: to make first.
            source: what an error names, such as the file.

        Raises:
            MeshError: one of them cannot be repaired.
        """
        count = len(replace(self, component=1).repaired(repairs).report.components)
        if count < 2:
            return (self.repaired(repairs).mesh_from(source),)
        names = [f"{self.name}, component {one}".lstrip(", ") for one in range(1, count + 1)]
        parts = (replace(self, name=name, component=one) for one, name in enumerate(names, 1))
        made = (part.repaired(repairs).mesh_from(source) for part in parts)
        # That one was taken is no news where all are.
        return tuple(
            mesh.with_labels(
                notes=[note for note in mesh.notes if not note.startswith(f"Component {one} of")]
            )
            for one, mesh in enumerate(made, 1)
        )

    def repair_steps(self, repairs: Repairs = NO_REPAIRS) -> Steps[RepairOutcome]:
        """As `repaired`, with checkpoints between."""
        begun = yield from _begin(self.polygons, repairs)
        yield
        report = validate(begun.polygons, RepairChoices(self.component, repairs.drop_walls))
        report.numbering = begun.numbering.followed_by(report.numbering)
        walls = (wall_record(report.findings),) if repairs.drop_walls else ()
        return RepairOutcome(self, repairs, (*begun.records, *walls), begun.findings, report)

    def suggestion_steps(self) -> Steps[Repairs]:
        """Find the repairs that make a mesh of it, or bring it nearest to one, and their values.

        Each is looked for in what those before it leave.
        """
        prepared = without_duplicates(self.polygons)
        if prepared.stopped:
            return NO_REPAIRS
        surface = Surface(prepared.vertices, prepared.faces, prepared.numbering)
        found: dict[str, object] = {}
        for name, repair in NAMED_REPAIRS.items():
            yield
            value = repair.suggest(surface)
            if value is None or value is False:
                continue
            if repair.make is None:
                found[name] = value
                continue
            repaired, record = repair.make(surface, value)
            if record.count:
                surface, found[name] = repaired, value
        return Repairs(**found)  # type: ignore[arg-type]

    def suggested(self) -> Repairs:
        """As `suggestion_steps`."""
        return finish(self.suggestion_steps())


@dataclass(frozen=True, eq=False)
class RepairOutcome:
    """The account of what repairs make of a body.

    Attributes:
        body: that was to be repaired.
        repairs: asked for.
        records: of those made, in their order.
        findings: of what was put right before them, such as duplicated vertices.
        report: of the validation after them.
    """

    body: RawBody
    repairs: Repairs
    records: tuple[RepairRecord, ...]
    findings: tuple[Finding, ...]
    report: ValidationReport

    @property
    def usable(self) -> bool:
        """Whether it is a mesh now."""
        return not self.report.fatal

    @property
    def moved(self) -> float:
        """The largest distance that a repair asked for moved a vertex, in the body's unit."""
        return max((record.moved for record in self.records), default=0.0)

    @property
    def notes(self) -> tuple[str, ...]:
        """Everything that was done but by the checks, which have findings of their own, one sentence each."""
        made = (record for record in self.records if NAMED_REPAIRS[record.name].make is not None)
        return (*self.body.notes, *(f"{record.sentence}." for record in made))

    @property
    def diagnosis(self) -> Diagnosis:
        """Sizes of the result and everything that is wrong with it."""
        findings = (*self.findings, *self.report.findings)
        told = diagnosis_of(self.report)
        return replace(
            told, findings=findings, notes=self.notes, unit=self.body.unit, advice=self.advice.options
        )

    @property
    def advice(self) -> Repairs:
        """The repairs that make a mesh of the body where these do not; none where nothing helps."""
        if self.usable:
            return NO_REPAIRS
        suggested = self.body.suggested()
        helps = bool(suggested) and suggested != self.repairs and self.body.repaired(suggested).usable
        return suggested if helps else NO_REPAIRS

    @property
    def problem(self) -> str:
        """The reason why it is no mesh, on one line; empty where it is one."""
        return "" if self.usable else str(MeshError.from_report(self.report))

    @property
    def mesh(self) -> Mesh:
        """The mesh that it is now.

        Raises:
            MeshError: it is none; one line says what is left.
        """
        return self.mesh_from(self.body.name)

    def mesh_from(self, source: str) -> Mesh:
        """The mesh that it is now.

        Args:
            source: what an error names, such as the file.

        Raises:
            MeshError: it is none; one line says what is left, and the error carries the body.
        """
        report = self.report
        if report.fatal:
            raise BrokenBodyError.about(self, source)
        findings = (*self.findings, *report.findings)
        if any(finding.kind == "flat_faces" for finding in report.findings):
            # All other checks follow the repairs that could spoil them; flips come late, so all is checked
            # again.
            again = validate(PolygonSoup.of(report.vertices, report.faces), RepairChoices(strict=True))
            if again.repaired:
                raise MeshError.from_report(again, source)
            again.numbering = report.numbering
            report = again
        notes = tuple(dict.fromkeys((*self.notes, *(finding.note for finding in findings))))
        return Mesh.from_report(report, self.body.name, notes).with_labels(unit=self.body.unit)


class BrokenBodyError(MeshError):
    """A body that is no mesh, but can be looked at, and repaired perhaps.

    Attributes:
        body: as it was read.
        advice: the repairs that make a mesh of it; none where it takes more than these.
    """

    body: RawBody
    advice: Repairs = NO_REPAIRS

    @classmethod
    def about(cls, outcome: RepairOutcome, source: str) -> BrokenBodyError:
        """Tell what is fatal in an outcome, and which repairs would help.

        Args:
            outcome: that is no mesh.
            source: what the error names, such as the file.
        """
        told = MeshError.from_report(outcome.report, source)
        advice = outcome.advice
        if not advice:
            parts = outcome.body.parts if told.components and len(outcome.body.parts) > 1 else ()
            choice = f"; or one of its parts by name, part={parts[0].name!r}" if parts else ""
            error = cls(f"{told}{choice}", told.findings, told.components)
            error.parts = parts
        else:
            # Into how many pieces a surface falls does not count beside what they come from.
            fatal = [finding for finding in outcome.report.findings if finding.fatal]
            told_of = [finding for finding in fatal if finding.kind not in COMPONENT_KINDS] or fatal
            start = f"{source}: " if source else ""
            error = cls(
                f"{start}{'; '.join(finding.message for finding in told_of)}; {advice_text(advice)}",
                told.findings,
            )
            error.advice = advice
        error.body = outcome.body
        return error


def advice_text(advice: Repairs) -> str:
    """The repairs that help, as the end of a sentence.

    >>> advice_text(Repairs(weld=1e-4))
    'a repair mends it: --weld 1e-4, in Python repairs=Repairs(weld=0.0001)'
    """
    values = ", ".join(f"{name}={value!r}" for name, value in advice.asked.items())
    return f"a repair mends it: {advice.options}, in Python repairs=Repairs({values})"


@dataclass(frozen=True, eq=False)
class _Begun:
    """What the repairs asked for make of polygons, before any check."""

    polygons: PolygonSoup
    numbering: FileNumbering
    records: tuple[RepairRecord, ...] = ()
    findings: tuple[Finding, ...] = field(default=())


def _begin(polygons: PolygonSoup, repairs: Repairs) -> Steps[_Begun]:
    unchanged = _Begun(polygons, FileNumbering.unchanged(len(polygons.vertices)))
    if all(NAMED_REPAIRS[name].make is None for name in repairs.asked):
        return unchanged
    prepared = without_duplicates(polygons)
    if prepared.stopped:
        return unchanged  # the validation tells of it
    surface = Surface(prepared.vertices, prepared.faces, prepared.numbering)
    records = []
    for name, value in repairs.asked.items():
        yield
        make = NAMED_REPAIRS[name].make
        if make is not None:
            surface, record = make(surface, value)
            records.append(record)
    sizes = np.full(len(surface.faces), 3)
    repaired = PolygonSoup(surface.vertices, surface.faces.ravel(), sizes)
    return _Begun(repaired, surface.numbering, tuple(records), tuple(prepared.findings))
