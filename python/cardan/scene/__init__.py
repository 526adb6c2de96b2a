"""Scenes: a driveline, its load, drive angles and study in one short file, and what they give."""

from cardan.scene.errors import SceneError
from cardan.scene.scene import Scene, SceneResult
from cardan.scene.streaming import stream
from cardan.scene.study import Axis, Column, StudyResult

__all__ = ["Axis", "Column", "Scene", "SceneError", "SceneResult", "StudyResult", "stream"]
