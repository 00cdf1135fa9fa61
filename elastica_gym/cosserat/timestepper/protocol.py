"""Time steppers under PyElastica's names for annotations."""

from .symplectic_steppers import SymplecticStepper

StepperProtocol = SymplecticStepperProtocol = SymplecticStepper
