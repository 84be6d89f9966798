"""A plane wave at a joint that slips at constant strength, at any angle below the critical ones.

Along the joint all depends on t - p x, p the slowness of the wave. Waves leave each half-space with
the velocity Y T of their traction T on the joint, Y a constant matrix, so that the jump [u] of the
joint follows

    [u]' = (Y+ - Y-) T - v_I + Y- T_I,   T_n = K_n [u_n],  T_s = K_s ([u_s] - slip),  |T_s| <= c

with v_I, T_I the incident wave's own. Heun's method. Axes t along and n across the joint, in the
direction of travel; written for tests alone."""

import numpy as np

STEP = 4e-6  # s: 1e-5 of a wave of 200 Hz at a linear joint


def slipping_joint(scene, points, times):
    """Return the velocity [points, times, (x, y)], m/s, of the one wave and joint of a scene."""
    from jointwave.cases.incident import plane_wave

    wave, joint = plane_wave(scene, scene.waves[0]), scene.joint_sets[0]
    dip, through = np.radians(joint.dip), np.array(joint.through)
    n = np.array([-np.sin(dip), np.cos(dip)])
    n *= np.sign(wave.direction @ n)
    axes = np.array([[-n[1], n[0]], n])
    a, b, rho = (float(getattr(wave.rock, k)) for k in ("p_speed", "s_speed", "density"))
    p = float(wave.direction @ axes[0]) / wave.speed
    q = np.sqrt(np.array([1 / a**2, 1 / b**2]) - p**2)
    down = unit_waves(a, b, rho, p, q)  # along +n
    back = unit_waves(a, b, rho, p, -q)
    k = "PS".index(scene.waves[0].kind)
    sent = np.zeros(2)
    sent[k] = np.sign(down[0][:, k] @ axes @ wave.polarisation)
    tau = np.arange(-1e-3, times[-1] + 0.03, STEP)
    arrives = wave.pulse.value(tau)
    T = tractions(joint, down, back, sent, arrives)
    after = np.linalg.solve(down[1], T.T)
    before = np.linalg.solve(back[1], T.T - np.outer(down[1] @ sent, arrives))
    lead, found = q[k] * ((through - wave.through) @ n), []
    for at in points:
        t = times - p * ((at - wave.through) @ axes[0]) - lead
        z = (at - through) @ n
        waves, motion = (after, down[0]) if z > 0 else (before, back[0])
        v = sum(np.interp(t - q[m] * abs(z), tau, waves[m])[:, None] * motion[:, m] for m in (0, 1))
        if z < 0:
            v = v + wave.pulse.value(t - q[k] * z)[:, None] * (down[0] @ sent)
        found.append(v @ axes)
    return np.array(found)


def unit_waves(a, b, rho, p, q):
    """Return velocity and traction (t, n) of unit P and S waves of slowness p along and q across
    the joint, columns; stress -(lambda (s.g) I + mu (s g + g s))."""
    s = np.array([[p, q[0]], [p, q[1]]])
    g = np.array([a * s[0], b * np.array([s[1][1], -s[1][0]])])
    mu, lame = rho * b**2, rho * (a**2 - 2 * b**2)
    stress = [
        -(lame * (x @ y) * np.eye(2) + mu * (np.outer(x, y) + np.outer(y, x)))
        for x, y in zip(s, g, strict=True)
    ]
    return g.T, np.array([one[:, 1] for one in stress]).T


def tractions(joint, down, back, sent, arrives):
    """Return those of the joint at the samples of the incident pulse [samples, (t, n)], Pa."""
    Y, Y_back = (v @ np.linalg.inv(T) for v, T in (down, back))
    own, source = Y - Y_back, -down[0] @ sent + Y_back @ down[1] @ sent
    K = np.array([joint.shear_stiffness, joint.normal_stiffness])
    jump, slip, found = np.zeros(2), 0.0, []

    def held(jump):
        T = K * (jump - [slip, 0.0])
        return np.array([np.clip(T[0], -joint.cohesion, joint.cohesion), T[1]])

    for one, other in zip(arrives, [*arrives[1:], 0.0], strict=True):
        found.append(held(jump))
        first = own @ found[-1] + source * one
        second = own @ held(jump + STEP * first) + source * other
        jump = jump + STEP * (first + second) / 2
        slip = jump[0] - held(jump)[0] / K[0]
    return np.array(found)
