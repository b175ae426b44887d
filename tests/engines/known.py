"""An engine that knows the answer: its poses are exact, so that all error is the onlooker's."""

import math

from analytic import simulate
from engines import ENGINES
from engines.declaration import Stepping
from engines.run.drive import simulate_world
from engines.scene import ACCURACIES
from engines.world import Moment, Pose


class Bare:
    """What every world must answer, and nothing more."""

    moment = Moment.END

    def step(self, step):
        pass

    def fault(self):
        return ""

    def close(self):
        pass


def standing(scene, theta, rate):
    """Return the pose of a block that stands on the corner on the side of its lean."""
    half_width = math.copysign(0.5 * scene.system.width, theta)
    half_height = 0.5 * scene.system.height
    sine, cosine = math.sin(theta), math.cos(theta)
    x = half_width * (1.0 - cosine) + half_height * sine
    return Pose(x, half_width * sine + half_height * cosine, theta, rate)


class ScriptedWorld(Bare):
    """Has the rotation and rate that `script` says, and keeps the steps that it was given."""

    def __init__(self, scene):
        self.scene = scene
        self.steps = []
        self._pose = standing(scene, *scene.start)

    def script(self, time, rate_s):
        """Return the rotation at a time, and the rate at the moment of its step [s]."""
        raise NotImplementedError

    def step(self, step):
        self.steps.append(step)
        rate_s = step.end_s - (1.0 - self.moment.value) * step.dt_s
        self._pose = standing(self.scene, *self.script(step.end_s, rate_s))

    def state(self):
        return [self._pose]


class KnownWorld(ScriptedWorld):
    """The exact solution, its velocity at some moment of the step."""

    def __init__(self, scene, moment, stepping):
        super().__init__(scene)
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


class ElsewhereWorld(KnownWorld):
    """The exact solution on a base that is not where it should be, by `raised_m` of the time."""

    def __init__(self, scene, dt_s, raised_m):
        super().__init__(scene, Moment.END, Stepping.FIXED)
        self._dt_s, self._raised_m = dt_s, raised_m

    def state(self):
        (at,) = super().state()
        return [at._replace(z=at.z + self._raised_m(self._dt_s * len(self.steps)))]


def watched(world, posed, stepping):
    """Return what is seen of a world, in the equal steps of a scene or in steps that land."""
    dt_s = (posed.step or 1.0 / ACCURACIES[posed.accuracy]) / posed.system.p
    resolution = ENGINES["mujoco"].resolution(posed.system)
    return simulate_world(world, posed, dt_s, stepping, resolution)


def exactly(posed, moment, stepping):
    """Run a scene with exact poses; return what was made of them, and the steps."""
    world = KnownWorld(posed, moment, stepping)
    return watched(world, posed, stepping), world.steps
