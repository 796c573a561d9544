"""Writes wake.npy beside it: the waves behind a model boat, as a user might compute them (numpy 2.4).

A patch of pressure moves over deep water. Each wave is forced at the frequency at which the patch passes it, and a little friction
lets the waves trail behind. Source: Lamb, Hydrodynamics, 6th ed., §242 and §256.
"""
import os

import numpy as np

SPEED_M_S, RADIUS_M, STEP_M = 1.25, 0.07, 0.0375
G, FRICTION_PER_S = 9.81, 0.05

samples = 1024
x = (np.arange(samples) - samples // 2) * STEP_M
X, Z = np.meshgrid(x, x)  # rows run along x, row 0 is at the lowest z
pressure = np.exp(-(X**2 / (2 * (3 * RADIUS_M) ** 2) + Z**2 / (2 * RADIUS_M**2)))

k = 2 * np.pi * np.fft.fftfreq(samples, STEP_M)
KX, KZ = np.meshgrid(k, k)
K = np.hypot(KX, KZ)
passing = SPEED_M_S * KX + 1j * FRICTION_PER_S
heights = np.fft.ifft2(np.fft.fft2(pressure) * K / (passing**2 - G * K + 1e-9)).real
heights *= 0.045 / np.abs(heights).max()

boat = samples // 2  # the boat is at x = 0 and moves towards +x
rows, columns = slice(boat - 80, boat + 80), slice(boat - 190, boat + 50)
np.save(os.path.join(os.path.dirname(os.path.abspath(__file__)), "wake.npy"), heights[rows, columns].astype(np.float32))
print(heights[rows, columns].min(), heights[rows, columns].max())
