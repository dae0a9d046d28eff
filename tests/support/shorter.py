"""Settings that make the shipped scenes short enough for a test. Their numbers mean nothing then; that they run does."""

import tomllib

from rodwake import SCENES

LONG = {"pair_crystal", "pair_density", "pair_fluid", "pair_series"}  # minutes, and nothing to draw of less: only checked


def settings(**keys):
    return [part for key, value in keys.items() for part in ("-s", f"{key.replace('__', '.')}={value}")]


def bed(duration, frames, runs=1, **keys):
    return settings(granular__duration=duration, granular__output__frames=frames, granular__runs=runs, granular__equilibrate=0.05, **keys)


SHORTER = {"dish": bed(0.3, 0.1), "rod_in_bed": settings(granular__duration=0.5, granular__equilibrate=0.05),  # its film has a hundred pictures
           "order": bed(0.35, 0.01, measure__block=0.1, measure__order_interval=0.05), "memory_kernel": bed(0.35, 0.037), "wake": bed(0.6, 0.05, measure__from=0),
           "quickstart": bed(1.0, 0.1, 2, measure__interval=0.05, measure__from=0, measure__block=0.2, measure__spacing="4 a",
                            fit__masks='[{strip="10 a",radius="16 a"},{strip="8 a",radius="15 a"}]'), "wake_large": bed(0.2, 0.02, measure__from=0), "bead_drag": bed(0.5, 0.1), "pursuit_bed": bed(0.3, 0.1, 2),
           "bound_contacts": settings(scan__axes__0__values=[0.0, 2.0], scan__axes__1__count=4, rods_run__t_end=5),
           "crowd": settings(rods_random__count=40, rods_run__t_end=4, rods_order__from=1),
           "crowd_in_box": settings(rods_random__count=20, rods_random__extent=10, medium__periodic=10, rods_run__t_end=2, rods_order__from=1),
           "crowd_with_bodies": settings(rods_random__count=30, rods_random__extent=10, rods_run__t_end=4, rods_order__from=1),
           "crowd_dynamic": settings(rods_random__count=80, rods_run__t_end=1, rods_order__from=0, medium__dynamic__modes=100, medium__dynamic__force_width=0.85),
           "medium_film": settings(rods_run__t_end=2, medium__dynamic__film_interval=0.5),
           "pair_measured": bed(1.0, 0.1, measure__interval=0.05, measure__from=0, measure__block=0.2, measure__spacing="2 a", medium__measured__smoothing=1,
                               medium__measured__samples=2, field__nx=20, field__ny=20),
           "bed_quick": bed(1.0, 0.1, 2, measure__interval=0.02, measure__from_travel="0.2 a", measure__block=0.2, measure__phonon_lag=0.1,
                            measure__heading_lag_low=0.02, measure__heading_lag_high=0.1),
           "posterior": settings(fit__posterior__samples=16, fit__posterior__chains=1), "own_lab": settings(granular__duration=0.5, granular__output__frames=0.1),
           "crowd_far": settings(rods_run__t_end=0.5, rods_run__output_times=[0.25]),
           "apolar_pair": bed(0.3, 0.1, 2), "two_sizes": bed(0.3, 0.05), "rods_in_bed": bed(0.3, 0.05), "pair_film": bed(0.5, 0.25), "pursuit_film": bed(0.5, 0.25), "capture_kappa": [], "capture_gamma": [], "orbit_decided": [], "critical": settings(scan__axes__0__count=2, scan__axes__1__values=[1.0, 2.0], scan__tolerance=1e-4), "rivals": [],
           "rod_noise": bed(0.5, 0.05, measure__from=0, measure__block=0.4), "capture_noise": settings(noise__runs=3, noise__most_runs=3),
           "force": bed(0.3, 0.1, 2), "phonons": bed(0.5, 0.037, measure__block=0.2), "body_force": bed(0.5, 0.1),
           "inertia": bed(0.5, 0.1, 2, measure__from=0, measure__block=0.2),
           "pair_unstrained_0": bed(0.3, 0.1, 2), "pair_unstrained_90": bed(0.3, 0.1, 2), "pursuit_near": bed(0.3, 0.1, 2),
           "wake_scaling": bed(0.2, 0.02, measure__from=0, measure__block=0.1, granular__box="fit 78 a"),
           "tail": bed(0.5, 0.05, measure__from=0, measure__interval=0.05, measure__block=0.1, granular__box="78 a"), "drag": bed(0.5, 0.037, measure__block=0.2, measure__from=0), "noise": settings(noise__runs=50), "pair_dynamic": settings(rods_run__t_end=2),
           "pair_density_quick": settings(scan__axes__0__values=[0.66, 0.70], granular__runs=1)}
COARSE = settings(scan__resolution=16, scan__axes__0__count=8, scan__axes__1__count=8, scan__audit=10)  # of scans


def shorter(name):
    """Settings for the scene of this name, none for one that is short or not shipped."""
    scene = SCENES / f"{name}.toml"
    return SHORTER.get(name, COARSE if scene.is_file() and "scan" in tomllib.loads(scene.read_text()) else [])
