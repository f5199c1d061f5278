"""The bake that runs in this session, for the operator that polls it and the panel that shows it."""

import bpy
from bpy.app.handlers import persistent
from bpy.props import FloatProperty

from ..core import estimate, jobs
from . import handlers

job = None  # core.jobs.Job while one runs
title = ""  # what the progress bar says
report = ""  # the sentence that the last bake ended with
failed = False  # whether `report` is an error
notices = ()  # sentences on what the last bake made of its source
correction = 1.0  # of estimated times, as this session's bakes have it


def running():
    return job is not None


def start(work, name):
    """Runs `work(progress)` in the background."""
    global job, title, report, failed, notices
    title, report, failed, notices = name, "", False, ()
    job = jobs.Job(work, name)
    return job


def finish(sentence, is_error, about_source=()):
    global job, report, failed, notices
    job, report, failed, notices = None, sentence, is_error, tuple(about_source)


def learn(request, seconds):
    """Corrects the next estimate by what a bake took."""
    global correction
    correction = seconds / estimated(request.threads, quality_of(request), 1.0).seconds


def quality_of(request):
    names = ("resolution", "directions", "sdf_resolution", "facet_cells", "attribute_resolution", "terms", "layout", "precision",
             "memory")
    return {name: getattr(request, name) for name in names}


def estimated(threads, quality, factor=None):
    """The Estimate of a bake of this quality (BakeOptions.quality); raises ValueError."""
    return estimate.estimate(**quality, threads=threads, correction=correction if factor is None else factor)


def fraction():
    return job.fraction if job is not None else 0.0


def _fraction_property(_self):
    return fraction()


@persistent
def _on_load_pre(*_arguments):
    # The operator that polls the job goes away with the old file, so the job does too.
    if job is not None:
        job.cancel()
        finish("The bake was cancelled because another file was opened", False)


_HANDLERS = (("load_pre", _on_load_pre),)


def register():
    bpy.types.WindowManager.mesoshell_bake_fraction = FloatProperty(
        name="Progress", description="Of the bake that runs", min=0.0, max=1.0, get=_fraction_property)
    handlers.add(_HANDLERS)


def unregister():
    jobs.cancel_all()
    finish("", False)
    handlers.remove(_HANDLERS)
    del bpy.types.WindowManager.mesoshell_bake_fraction
