"""A master for FMUs of both versions, over FMPy: inputs with their derivatives, steps, states."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from fmpy import calloc, extract, free, read_model_description
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave

_RATES = ("", "_rate", "_rate2", "_rate3")


class Master:
    """One instance of an FMU at t = 0."""

    def __init__(self, path: Path, parameters: Mapping[str, float] | None = None) -> None:
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
        self.messages: list[str] = []
        self._instantiate()
        self.start(parameters or {})

    def _instantiate(self) -> None:
        if self.is_3:
            self.fmu.instantiate(
                logMessage=lambda of, status, category, message: self.messages.append(message.decode())
            )
            return
        self.callbacks = fmi2CallbackFunctions()
        told = lambda of, name, status, category, message: self.messages.append(message.decode())  # noqa: E731
        self.callbacks.logger = fmi2CallbackLoggerTYPE(told)
        self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.fmu.instantiate(callbacks=self.callbacks)

    def start(self, parameters: Mapping[str, float]) -> None:
        if not self.is_3:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        for name, value in parameters.items():
            self.set(name, value)
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

    def slopes(self, unknown: str, known: list[str]) -> np.ndarray:
        """Directional derivatives of an output by inputs, each alone."""
        references = [self.references[name] for name in known]
        return np.array(
            [self.fmu.getDirectionalDerivative([self.references[unknown]], [one], [1.0])[0] for one in references]
        )

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
        self.start({})

    def close(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)
