"""An engine that knows the answer: its poses are exact, so that all error is the onlooker's."""

import math
from dataclasses import replace

from given import Bare

from analytic import simulate
from engines import ENGINES
from engines.declaration import Stepping
from engines.run.run import simulate_world
from engines.scene import ACCURACIES
from engines.world import Moment, Pose


def standing(scene, theta, rate):
    """Return the pose of a block that stands on the corner on the side of its lean."""
    half_width = math.copysign(0.5 * scene.system.width, theta)
    half_height = 0.5 * scene.system.height
    sine, cosine = math.sin(theta), math.cos(theta)
    x = half_width * (1.0 - cosine) + half_height * sine
    return Pose(x, half_width * sine + half_height * cosine, theta, rate)


class ScriptedWorld(Bare):
    """Rotates as `script` says, raised by `raised_m(time, theta)`, and keeps the steps given."""

    def __init__(self, scene, raised_m=lambda time, theta: 0.0):
        self.scene, self.steps, self._raised_m = scene, [], raised_m
        self._pose, self._time = standing(scene, *scene.start), 0.0

    def script(self, time, rate_s):
        """Return the rotation at a time, and the rate at the moment of its step [s]: none."""
        return 0.0, 0.0

    def step(self, step):
        self.steps.append(step)
        self._go(step.end_s, step.end_s - (1.0 - self.moment.value) * step.dt_s)

    def state(self):
        raised = self._raised_m(self._time, self._pose.theta)
        return [self._pose._replace(z=self._pose.z + raised)]

    def _go(self, time, rate_s):
        self._time = time
        self._pose = standing(self.scene, *self.script(time, rate_s))


class KnownWorld(ScriptedWorld):
    """The exact solution, its velocity at some moment of the step."""

    def __init__(self, scene, moment=Moment.END, stepping=Stepping.FIXED, **options):
        super().__init__(scene, **options)
        self.moment = moment
        self._ahead = {}
        if stepping is Stepping.FIXED and scene.step and scene.duration:
            dt_s = scene.step / scene.system.p
            # equal steps are known before: one solution for all of them
            ends = [dt_s * (i + 1) for i in range(math.ceil(scene.duration / dt_s) + 1)]
            rated = [end - (1.0 - moment.value) * dt_s for end in ends]
            # they end where the block lies on its side
            found = zip(self._exact(ends)[0], self._exact(rated)[1], strict=False)
            self._ahead = dict(enumerate(found, start=1))

    def _exact(self, times):
        scene = self.scene
        long = max(scene.motion.duration, times[-1])
        found = simulate(scene.system, scene.motion, start=scene.start, duration=long, times=times)
        return found.history.theta.tolist(), found.history.velocity.tolist()

    def script(self, time, rate_s):
        if self._ahead:
            lying = math.copysign(0.5 * math.pi, self._pose.theta), self._pose.rate
            return self._ahead.get(len(self.steps), lying)
        first, last = sorted((time, rate_s))
        thetas, rates = self._exact([first, last] if first < last else [first])
        return thetas[time > rate_s], rates[rate_s > time]


class SelfSteppingWorld(KnownWorld):
    """The exact solution, at the times to which it is told to go by steps of its own."""

    def __init__(self, scene):
        super().__init__(scene, Moment.END, Stepping.OWN)

    def advance(self, end_s):
        self.steps.append(end_s)
        self._go(end_s, end_s)
        return 3


def watched(world, posed, stepping, **declared):
    """Return what is seen of a world, in steps that a scene is given, land or are its own."""
    dt_s = (posed.step or 1.0 / ACCURACIES[posed.accuracy]) / posed.system.p
    resolution = replace(ENGINES["mujoco"], **declared).use(posed).resolution
    return simulate_world(world, posed, dt_s, stepping, resolution)


def exactly(posed, moment, stepping):
    """Run a scene with exact poses; return what was made of them, and the steps."""
    world = KnownWorld(posed, moment, stepping)
    return watched(world, posed, stepping), world.steps
