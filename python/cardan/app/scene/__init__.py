"""Scenes: a driveline, its load, drive angles and study in one short file, and what they give."""

from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.machine import machine_data
from cardan.app.scene.scene import BallJointScene, Scene, SceneResult, load_scene
from cardan.app.scene.sections.ball_joint import BallJointCase, Material
from cardan.app.scene.starters import STARTERS
from cardan.app.scene.study import cluster
from cardan.app.scene.study.curves import stream
from cardan.app.scene.study.states import States, StatesResult
from cardan.app.scene.study.study import Axis, Column, StudyResult

__all__ = [
    "STARTERS",
    "Axis",
    "BallJointCase",
    "BallJointScene",
    "Column",
    "Material",
    "Scene",
    "SceneError",
    "SceneResult",
    "States",
    "StatesResult",
    "StudyResult",
    "cluster",
    "load_scene",
    "machine_data",
    "stream",
]
