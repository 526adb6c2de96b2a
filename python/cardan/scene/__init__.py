"""Scenes: a driveline, its load, drive angles and study in one short file, and what they give."""

from cardan.scene.ball_joint import BallJointCase, Material
from cardan.scene.ball_joint_scene import BallJointScene
from cardan.scene.errors import SceneError
from cardan.scene.loading import load_scene
from cardan.scene.scene import Scene, SceneResult
from cardan.scene.states import States, StatesResult
from cardan.scene.streaming import stream
from cardan.scene.study import Axis, Column, StudyResult

__all__ = [
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
    "load_scene",
    "stream",
]
