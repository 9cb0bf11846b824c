"""Blur of a lens, which spreads light as a normal distribution."""

import cv2
import numpy as np

# Blurs in between are mixtures of two blurs whose variances differ by at most this. A mixture has the
# variance that is asked for; the error of its fourth moment is of second order in the step.
_VARIANCE_STEP = 0.05  # px^2


def blurred(light: np.ndarray, deviations: np.ndarray) -> np.ndarray:
    """The image, blurred at each pixel with the standard deviation given for it, in pixels."""
    variances = np.square(np.broadcast_to(deviations, light.shape))
    least, most = variances.min(), variances.max()
    levels = np.linspace(least, most, 1 + int(np.ceil((most - least) / _VARIANCE_STEP)))
    result = np.zeros_like(light)
    for level in levels:
        kernel = normal_kernel(float(np.sqrt(level)))
        evenly = cv2.sepFilter2D(light, cv2.CV_64F, kernel, kernel, borderType=cv2.BORDER_REPLICATE)
        if len(levels) == 1:
            return evenly
        step = levels[1] - levels[0]
        result += np.maximum(0.0, 1.0 - np.abs(variances - level) / step) * evenly
    return result


def normal_kernel(deviation: float) -> np.ndarray:
    """Weights at whole pixels of a normal distribution, adjusted to have exactly this variance.

    Below about half a pixel, plain samples of the distribution have too small a variance.
    """
    if deviation == 0.0:
        return np.ones(1)
    reach = int(np.ceil(5.0 * deviation + 1.0))
    offsets = np.arange(-reach, reach + 1)

    def samples(sampled_deviation: float) -> np.ndarray:
        weights = np.exp(-0.5 * np.square(offsets / sampled_deviation))
        return weights / weights.sum()

    lower, upper = 1e-3, 2.0 * deviation + 0.5
    for _ in range(60):
        middle = 0.5 * (lower + upper)
        if (samples(middle) * offsets**2).sum() < deviation**2:
            lower = middle
        else:
            upper = middle
    return samples(upper)
