"""Balancing against the textbook: four-bar and slider-crank, a spatial four-bar, bounds with their proof."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.points.cycle import cycle_of
from sevenbar.errors import RequestError
from sevenbar.forces.counterweights import counterweights, lower_bound
from sevenbar.forces.mounts import Mount
from sevenbar.forces.shaking import shaking_of

ROWS = 180


def unit_shaking(place, turn, speed=1.0, metre=1.0):
    """The (n, 4, 6) of a link with origin `place` (n, 3) and axes `turn` (n, 3, 3), rates by Fourier series."""
    wave = (1j * speed * np.fft.fftfreq(len(place), 1 / len(place))) ** 2

    def twice(values):
        flat = values.reshape(len(values), -1)
        return np.fft.ifft(wave[:, None] * np.fft.fft(flat, axis=0), axis=0).real.reshape(values.shape)

    return unit_from(place, turn, twice(place), twice(turn), metre)


def unit_from(place, turn, acceleration, second, metre):
    unit = np.zeros((len(place), 4, 6))
    unit[:, 3, 3:] = -metre * acceleration
    unit[:, 3, :3] = -(metre**2) * np.cross(place, acceleration)
    for j in range(3):
        unit[:, j, 3:] = -metre * second[:, :, j]
        unit[:, j, :3] = -(metre**2) * (
            np.cross(place, second[:, :, j]) + np.cross(turn[:, :, j], acceleration)
        )
    return unit


def about_z(angle):
    c, s, n = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    return np.stack([np.stack([c, -s, n], -1), np.stack([s, c, n], -1), np.stack([n, n, n + 1], -1)], axis=1)


def along(angle, length):
    return length * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])


def shaking(unit, mass, centre):
    return np.einsum("njw,j->nw", unit, [*(mass * np.asarray(centre)), mass])


@pytest.fixture(scope="module")
def four_bar():
    """Crank, coupler and rocker of a planar four-bar, at constant speed of the crank."""
    a, b, c, d = 0.05, 0.16, 0.12, 0.14
    crank = math.tau * np.arange(ROWS) / ROWS
    pin = along(crank, a)
    ground = np.array([d, 0.0, 0.0])
    way = ground - pin
    reach = np.linalg.norm(way, axis=1)
    coupler = np.arctan2(way[:, 1], way[:, 0]) + np.arccos((b**2 + reach**2 - c**2) / (2 * b * reach))
    far = pin + along(coupler, b)
    rocker = np.arctan2(far[:, 1], far[:, 0] - d)
    still = np.zeros_like(pin)
    return SimpleNamespace(
        lengths=(a, b, c),
        units=[
            unit_shaking(still, about_z(crank), 30.0),
            unit_shaking(pin, about_z(coupler), 30.0),
            unit_shaking(still + ground, about_z(rocker), 30.0),
        ],
    )


@pytest.mark.parametrize("aside", [0.0, 0.02])
def test_a_four_bar_is_balanced_as_berkof_and_lowen_say(four_bar, aside):
    # coupler of mass m at (u, v): the crank takes m a (1 - (u + i v) / b) of it, the rocker m c (u + i v) / b
    a, b, c = four_bar.lengths
    mass, u = 0.7, 0.06
    crank, rocker = (0.3, 0.02), (0.4, 0.05)
    total = (
        shaking(four_bar.units[0], crank[0], (crank[1], 0, 0))
        + shaking(four_bar.units[1], mass, (u, aside, 0))
        + shaking(four_bar.units[2], rocker[0], (rocker[1], 0, 0))
    )
    mounts = [
        Mount(i, four_bar.units[i - 1], axis=(0, 0, 1), name=n) for i, n in ((1, "crank"), (3, "rocker"))
    ]
    found = counterweights(total, mounts, size=b, radius=0.03)
    assert found.before > 30
    assert found.after < 1e-11 * found.before
    part = (u + 1j * aside) / b
    wanted = [-crank[0] * crank[1] - mass * a * (1 - part), -rocker[0] * rocker[1] - mass * c * part]
    for one, product in zip(found.counterweights, wanted, strict=True):
        assert one.product * one.direction == pytest.approx([product.real, product.imag, 0.0], abs=1e-12)
        assert one.mass == pytest.approx(abs(product) / 0.03)
        assert one.body.centre == pytest.approx(tuple(0.03 * one.direction))
    assert (found.rank, found.unknowns) == (4, 6)
    assert found.idle == (
        "link 1: mass times radius along the axis of crank",
        "link 1: a mass in the pivot",
        "link 3: mass times radius along the axis of rocker",
        "link 3: a mass in the pivot",
    )
    # the bodies themselves, added, leave nothing
    left = total + sum(
        shaking(four_bar.units[link - 1], body.mass, body.centre) for link, body in found.bodies.items()
    )
    assert np.abs(left[:, 3:]).max() < 1e-10 * found.before


def test_radii_count_from_the_pivot_wherever_points_are_written_from(four_bar):
    # the crank's points written from a place 0.2 off its axis: the same product, and its centre moved by it
    unit = four_bar.units[0].copy()
    off = np.array([0.2, -0.1, 0.3])
    unit[:, 3] -= np.einsum("j,njw->nw", off, unit[:, :3])
    total = shaking(four_bar.units[0], 2.0, (0.03, 0.01, 0.0))
    plain = counterweights(total, [Mount(1, four_bar.units[0])], size=0.1, radius=0.05)
    moved = counterweights(total, [Mount(1, unit, pivot=tuple(off))], size=0.1, radius=0.05)
    assert plain.after < 1e-11 * plain.before
    assert moved.after < 1e-11 * moved.before
    assert moved.counterweights[0].product == pytest.approx(plain.counterweights[0].product)
    assert moved.counterweights[0].body.centre == pytest.approx(plain.counterweights[0].body.centre + off)


@pytest.fixture(scope="module")
def slider_crank():
    """A slider-crank with its rod as two masses: crank r = 0.1, rod l = 0.35, 50 rad/s; piston side 2 kg, pin side 1.5 kg."""
    r, rod, speed, piston, pin = 0.1, 0.35, 50.0, 2.0, 1.5
    crank = math.tau * np.arange(ROWS) / ROWS
    place = np.zeros((ROWS, 3))
    place[:, 0] = r * np.cos(crank) + np.sqrt(rod**2 - (r * np.sin(crank)) ** 2)
    straight = np.broadcast_to(np.eye(3), (ROWS, 3, 3))
    units = [unit_shaking(np.zeros((ROWS, 3)), about_z(crank), speed), unit_shaking(place, straight, speed)]
    total = shaking(units[0], pin, (r, 0, 0)) + shaking(units[1], piston, (0, 0, 0))
    return SimpleNamespace(
        r=r, rod=rod, speed=speed, piston=piston, pin=pin, crank=crank, units=units, total=total
    )


def test_a_slider_crank_shakes_with_its_primary_and_secondary_orders(slider_crank):
    s = slider_crank
    reciprocating = shaking(s.units[1], s.piston, (0, 0, 0))
    found = shaking_of(reciprocating, s.crank, period=math.tau, time=s.crank)
    whole, q = s.piston * s.r * s.speed**2, s.r / s.rod
    assert found.orders[1, 3] == pytest.approx(whole, rel=1e-12)
    # A2 = q + q^3 / 4 + 15 q^5 / 128 + 35 q^7 / 512, and a part in a million
    second = q + q**3 / 4 + 15 * q**5 / 128 + 35 * q**7 / 512
    assert found.orders[2, 3] == pytest.approx(whole * second, rel=1e-5)
    assert np.abs(found.orders[3::2, 3]).max() < 1e-9 * whole
    # greatest at the outer dead centre: r w^2 (1 + r / l)
    assert found.force.value == pytest.approx(whole * (1 + q), rel=1e-10)
    assert found.force.input == pytest.approx(0.0, abs=1e-9) or found.force.input == pytest.approx(math.tau)
    assert found.moment.value == pytest.approx(0.0, abs=1e-9)


def test_the_crank_of_a_slider_crank_balances_half_of_the_reciprocating_mass(slider_crank):
    # classical: all that rotates, and half of what reciprocates, for the least mean square
    s = slider_crank
    found = counterweights(s.total, [Mount(1, s.units[0], axis=(0, 0, 1), name="crank")], size=s.rod)
    (one,) = found.counterweights
    assert one.product == pytest.approx((s.pin + s.piston / 2) * s.r, rel=1e-12)
    assert one.direction == pytest.approx([-1, 0, 0], abs=1e-12)
    assert one.mass is None
    assert found.rank == 2
    # the other half of the primary order now turns backwards: as much across as along
    after = shaking_of(found.shaking, s.crank, period=math.tau, time=s.crank)
    assert after.orders[1, 3:5] == pytest.approx([s.piston / 2 * s.r * s.speed**2] * 2, rel=1e-12)
    assert after.rms_force == pytest.approx(found.after, rel=1e-12)


def test_within_loose_bounds_cones_find_the_least_squares(slider_crank):
    s = slider_crank
    mount = [Mount(1, s.units[0])]
    free = counterweights(s.total, mount, size=s.rod)
    bound = counterweights(s.total, mount, size=s.rod, radius=0.2, most_mass=10.0)
    assert bound.status == "Solved"
    assert bound.after == pytest.approx(free.after, rel=1e-9)
    assert bound.bound <= bound.after <= bound.bound * (1 + 1e-7)
    assert bound.gap < 1e-7
    (one,) = bound.counterweights
    assert one.product == pytest.approx(free.counterweights[0].product, rel=1e-4)
    # no more mass than is needed at the full radius
    assert one.mass == pytest.approx(one.product / 0.2)


def test_a_bound_that_is_met_is_used_to_its_end(slider_crank):
    s = slider_crank
    (one,) = counterweights(
        s.total, [Mount(1, s.units[0])], size=s.rod, radius=0.05, most_mass=2.0
    ).counterweights
    assert one.mass == pytest.approx(2.0, rel=1e-6)
    assert one.product == pytest.approx(0.1, rel=1e-6)
    assert one.direction == pytest.approx([-1, 0, 0], abs=1e-4)


def test_the_least_greatest_force_is_that_of_a_fine_search(slider_crank):
    s = slider_crank
    found = counterweights(
        s.total, [Mount(1, s.units[0])], size=s.rod, radius=0.2, most_mass=10.0, measure="greatest"
    )
    unit, low, high = s.units[0][:, 0, 3:], 0.0, 1.0
    for _ in range(6):
        products = np.linspace(low, high, 201)
        forces = s.total[None, :, 3:] - products[:, None, None] * unit
        greatest = np.linalg.norm(forces, axis=2).max(axis=1)
        middle, half = products[np.argmin(greatest)], (high - low) / 50
        low, high, best = middle - half, middle + half, greatest.min()
    assert found.after == pytest.approx(best, rel=1e-8)
    assert found.after <= best * (1 + 1e-8)
    assert found.bound <= found.after
    assert found.gap < 1e-7


def test_no_point_within_the_bounds_is_below_the_lower_bound():
    rng = np.random.default_rng(5)
    constant, slopes = rng.normal(size=(20, 3)), rng.normal(size=(20, 3, 8))
    duals = rng.normal(size=(20, 3))
    duals /= np.linalg.norm(duals, axis=1).sum()
    bound = lower_bound(constant, slopes, -duals)
    for _ in range(2000):
        z = rng.uniform(size=2)
        y = rng.normal(size=(2, 3))
        y *= (z * rng.uniform(size=2) / np.linalg.norm(y, axis=1))[:, None]
        x = np.column_stack([y, z]).ravel()
        assert np.linalg.norm(constant + slopes @ x, axis=1).max() >= bound
        # without the floor at zero as well
        worst = lower_bound(constant + 10, slopes, duals)
        assert np.linalg.norm(constant + 10 + slopes @ x, axis=1).max() >= worst


@pytest.mark.parametrize("measure", ["rms", "greatest"])
def test_the_coupler_s_own_counterweight_weighs_on_its_pins(four_bar, measure):
    # a moving pivot: mass acts, and cannot be negative
    total = shaking(four_bar.units[1], 0.7, (0.06, 0.0, 0.0))
    mounts = [Mount(i, four_bar.units[i - 1]) for i in (1, 2, 3)]
    bounded = counterweights(total, mounts, size=0.16, radius=0.05, most_mass=0.3, measure=measure)
    for one in bounded.counterweights:
        assert 0 <= one.mass <= 0.3 * (1 + 1e-9)
        assert one.product <= 0.05 * one.mass * (1 + 1e-9)
    assert bounded.after < bounded.before
    assert bounded.gap < 1e-7
    fewer = counterweights(
        total, [mounts[0], mounts[2]], size=0.16, radius=0.05, most_mass=0.3, measure=measure
    )
    assert bounded.after <= fewer.after * (1 + 1e-7)
    # least squares alone would take the coupler's mass away
    free = counterweights(total, [mounts[1]], size=0.16)
    (one,) = free.counterweights
    assert one.mass < 0
    assert one.body is None
    assert free.unknowns == 4


def test_three_links_of_a_four_bar_have_combinations_that_do_nothing(four_bar):
    total = shaking(four_bar.units[1], 0.7, (0.06, 0.0, 0.0))
    found = counterweights(total, [Mount(i, four_bar.units[i - 1]) for i in (1, 2, 3)], size=0.16)
    # crank 2, rocker 2, of the coupler 3 that repeat these: rank 4 of 10, three along z alone, three together
    assert (found.rank, found.unknowns) == (4, 10)
    assert found.idle[-1] == "3 combinations of several numbers"
    assert found.after < 1e-11 * found.before


def test_force_and_moment_together_are_weighed(four_bar):
    total = shaking(four_bar.units[1], 0.7, (0.06, 0.0, 0.0))
    mounts = [Mount(i, four_bar.units[i - 1]) for i in (1, 3)]
    only = counterweights(total, mounts, size=0.16)
    both = counterweights(total, mounts, size=0.16, moment=20.0)
    turning = counterweights(total, mounts, size=0.16, force=0.0, moment=20.0)

    def value(found, force, moment):
        return math.sqrt(
            (
                force**2 * (found.shaking[:, 3:] ** 2).sum(axis=1)
                + moment**2 * (found.shaking[:, :3] ** 2).sum(axis=1)
            ).mean()
        )

    assert both.after == pytest.approx(value(both, 1.0, 20.0), rel=1e-12)
    assert both.after < value(only, 1.0, 20.0)
    assert turning.after < value(both, 0.0, 20.0)
    assert turning.rank < turning.unknowns


def test_an_rssr_with_a_rod_as_coupler_is_balanced_by_crank_and_rocker():
    motion = sb.load("rssr").motion(ROWS, speed=10.0)
    lengths = motion.linkage.lengths
    rod = math.sqrt((lengths[0] - 700) ** 2 + lengths[2] ** 2 + 700**2)
    units = {}
    for link in (1, 2, 3):
        rates = cycle_of(motion, link, rows=ROWS).rates
        units[link] = unit_from(
            rates.constant[0], rates.gradient[0], rates.constant[2], rates.gradient[2], metre=1e-3
        )
    rng = np.random.default_rng(1)
    total = shaking(units[2], 1.3, (rod / 2, 0, 0))
    total += sum(shaking(units[link], 2.0, rng.uniform(-100, 100, 3)) for link in (1, 3))
    size = motion.circuits[0].size
    points = {point.name: point for point in motion.linkage.points}
    assert points["A"].at is not None
    found = counterweights(total, [Mount(link, units[link]) for link in (1, 3)], size=size, radius=100.0)
    assert found.before > 10
    assert found.after < 1e-11 * found.before
    assert found.rank == 4
    assert all(body.mass > 0 for body in found.bodies.values())


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"mounts": []}, "links: none given"),
        ({"twice": True}, "links: one is given twice"),
        ({"measure": "peak"}, "measure: 'peak' is not offered"),
        ({"measure": "greatest"}, "measure: the greatest shaking is found within bounds"),
        ({"most_mass": 1.0}, "radius: is missing"),
        ({"most_mass": -1.0, "radius": 1.0}, "most_mass: -1.0 of link 1; give kilograms > 0"),
        ({"most_mass": {2: 1.0}, "radius": 1.0}, "most_mass: none for link 1"),
        ({"radius": {1: 1.0, 3: 1.0}}, "radius: link 3 carries no counterweight; give it for 1"),
        ({"radius": 0.0}, "radius: 0.0 of link 1; give a length > 0"),
        ({"moment": -1.0}, "moment: -1.0 is not a factor"),
        ({"force": 0.0}, "force: neither force nor moment counts"),
    ],
)
def test_wrong_arguments_have_their_message(slider_crank, more, words):
    mounts = more.pop("mounts", [Mount(1, slider_crank.units[0])]) * (1 + more.pop("twice", 0))
    with pytest.raises(RequestError) as caught:
        counterweights(slider_crank.total, mounts, size=1.0, **more)
    assert str(caught.value).startswith(words)
