"""A master for FMUs of both versions, over FMPy: inputs with their derivatives, steps, states."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

_RATES = ("", "_rate", "_rate2", "_rate3")


class Master:
    """One instance of an FMU at t = 0."""

    def __init__(self, path: Path) -> None:
        self.folder = Path(tempfile.mkdtemp())
        extract(str(path), str(self.folder))
        self.description = read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.is_3 = self.description.fmiVersion.startswith("3")
        self.time = 0.0
        self.fmu = (FMU3Slave if self.is_3 else FMU2Slave)(
            guid=self.description.guid,
            unzipDirectory=str(self.folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.fmu.instantiate()
        self.start()

    def start(self) -> None:
        if not self.is_3:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def set(self, name: str, *values: float) -> None:
        """The value of an input and its derivatives at this time."""
        if self.is_3:
            self.fmu.setFloat64([self.references[name + rate] for rate in _RATES[: len(values)]], list(values))
            return
        self.fmu.setReal([self.references[name]], [values[0]])
        if len(values) > 1:
            orders = list(range(1, len(values)))
            self.fmu.setRealInputDerivatives([self.references[name]] * len(orders), orders, list(values[1:]))

    def get(self, *names: str) -> np.ndarray:
        references = [self.references[name] for name in names]
        return np.array(self.fmu.getFloat64(references) if self.is_3 else self.fmu.getReal(references))

    def step(self, step: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=step)
        self.time += step

    def save(self) -> bytes:
        """The serialised state."""
        if self.is_3:
            state = self.fmu.getFMUState()
            found = self.fmu.serializeFMUState(state)
            self.fmu.freeFMUState(state)
        else:
            state = self.fmu.getFMUstate()
            found = self.fmu.serializeFMUstate(state)
            self.fmu.freeFMUstate(state)
        return bytes(found)

    def restore(self, saved: bytes, time: float) -> None:
        if self.is_3:
            state = self.fmu.deserializeFMUState(saved)
            self.fmu.setFMUState(state)
            self.fmu.freeFMUState(state)
        else:
            state = self.fmu.deSerializeFMUstate(saved)
            self.fmu.setFMUstate(state)
            self.fmu.freeFMUstate(state)
        self.time = time

    def reset(self) -> None:
        self.fmu.reset()
        self.start()

    def close(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)
