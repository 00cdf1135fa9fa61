"""Compatibility with PyElastica 1.0.0 beyond the physics: shapes, files, keywords, small methods."""

import pickle
import warnings

import numpy as np
import pytest

import elastica_gym.cosserat as ours

theirs = pytest.importorskip("elastica", reason="pip install 'elastica-gym[bench]'")

X, Y, Z = np.eye(3)
DT = 1e-5
ROD = dict(base_length=0.3, base_radius=0.01, density=1000.0, youngs_modulus=1e5)


def simulator(lib):
    class Simulator(
        lib.BaseSystemCollection, lib.Constraints, lib.Forcing, lib.CallBacks, lib.Damping, lib.Connections
    ):
        pass

    return Simulator()


def make_rod(lib, n=8, **options):
    return lib.CosseratRod.straight_rod(n, np.zeros(3), Z.copy(), Y.copy(), **{**ROD, **options})


def make_systems(lib):
    return {
        "rod": make_rod(lib),
        "ring": lib.CosseratRod.ring_rod(8, np.ones(3), Z.copy(), Y.copy(), **ROD),
        "cylinder": lib.Cylinder(np.array([2.0, 0.0, 0.0]), Z.copy(), Y.copy(), 0.3, 0.01, 1000.0),
        "sphere": lib.Sphere(np.array([3.0, 0.0, 0.0]), 0.01, 1000.0),
        "plane": lib.Plane(np.array([0.0, 0.0, -5.0]), Z.copy()),
    }


# shapes


def shapes_of(system):
    """Return type, shape and dtype of all public attributes and of the results of ``compute_...`` methods."""
    found = {}
    for name in dir(system):
        value = None if name.startswith("_") else getattr(system, name)
        if callable(value) and name.startswith("compute_") and name != "compute_internal_forces_and_torques":
            try:
                value = value()
            except (AssertionError, ValueError):
                # twist is not defined for a ring
                value = None
        if isinstance(value, np.ndarray | np.generic):
            found[name] = isinstance(value, np.ndarray), value.shape, value.dtype
    return found


@pytest.mark.parametrize("name", make_systems(ours))
@pytest.mark.parametrize("is_finalized", [False, True], ids=["before", "after"])
def test_shapes(name, is_finalized):
    expected, found = {}, {}
    for lib, shapes in ((theirs, expected), (ours, found)):
        sim, systems = simulator(lib), make_systems(lib)
        sim.extend(systems.values())
        if is_finalized:
            sim.finalize()
        with warnings.catch_warnings():
            # PyElastica divides by a ring's dilatation before setting it
            warnings.simplefilter("ignore", RuntimeWarning)
            shapes.update(shapes_of(systems[name]))
    assert len(expected) > 1
    assert {attribute: found.get(attribute) for attribute in expected} == expected


def test_attributes_of_bodies_are_arrays():
    sim, cylinder = simulator(ours), make_systems(ours)["cylinder"]
    sim.append(cylinder)
    mass = cylinder.mass
    sim.finalize()
    cylinder.velocity_collection[0] = 2.0
    assert cylinder.mass[0] == mass and cylinder.compute_translational_energy()[0] == 2.0 * mass
    with pytest.raises(ValueError, match="read-only"):
        cylinder.mass[:] = 1.0


# steps by hand


@pytest.mark.parametrize("name", ["rod", "sphere"])
def test_accelerations_by_hand(name):
    found = []
    for lib in (theirs, ours):
        sim, systems = simulator(lib), make_systems(lib)
        sim.extend(systems.values())
        sim.finalize()
        system, rng = systems[name], np.random.default_rng(0)
        for attribute, size in (
            ("velocity_collection", 0.1),
            ("omega_collection", 3.0),
            ("external_forces", 0.01),
            ("external_torques", 1e-4),
        ):
            getattr(system, attribute)[:] = size * rng.standard_normal(getattr(system, attribute).shape)
        if name == "rod":
            system.position_collection[:] += 1e-3 * rng.standard_normal((3, 9))
        system.compute_internal_forces_and_torques(0.0)
        system.update_accelerations(0.0, DT)
        accelerations = system.acceleration_collection.copy(), system.alpha_collection.copy()
        system.zeroed_out_external_forces_and_torques(0.0)
        assert not system.external_forces.any() and not system.external_torques.any()
        found.append(accelerations)
    for expected, value in zip(*found, strict=True):
        assert np.abs(expected - value).max() <= 1e-9 * np.abs(expected).max()


# files


def numbered(folder):
    """Return the steps in each file of a folder, by name."""
    files = {}
    for path in sorted(folder.iterdir()):
        data = np.load(path) if path.suffix == ".npz" else pickle.loads(path.read_bytes())
        files[path.name] = data["step"].tolist()
    return files


@pytest.mark.parametrize(("n_steps", "interval"), [(200, 100), (250, 100), (199, 100), (150, 37), (300, 45), (40, 100)])
@pytest.mark.parametrize("method", ["npz", "pickle"])
def test_exported_files(n_steps, interval, method, tmp_path):
    files = []
    for lib in (theirs, ours):
        sim, rod, folder = simulator(lib), make_rod(lib), tmp_path / lib.__name__
        sim.append(rod)
        callbacks = []

        class Export(lib.ExportCallBack):
            def __init__(self, *args, _made=callbacks, **options):
                super().__init__(*args, **options)
                _made.append(self)

        sim.collect_diagnostics(rod).using(
            Export,
            step_skip=10,
            filename="rod",
            directory=str(folder),
            method=method,
            initial_file_count=2,
            file_save_interval=interval,
        )
        sim.finalize()
        (callback,) = callbacks
        assert callback.save_path == str(folder / "rod_{:02d}.{}")
        assert callback.get_last_saved_path().startswith(str(folder / "rod_01."))
        lib.integrate(lib.PositionVerlet(), sim, n_steps * DT, n_steps, progress_bar=False)
        sim.close()
        files.append(numbered(folder))
        assert callback.get_last_saved_path() == str(folder / list(files[-1])[-1])
    assert files[0] == files[1]


def test_exported_files_by_their_size(tmp_path):
    files = []
    for lib in (theirs, ours):
        sim, rod, folder = simulator(lib), make_rod(lib), tmp_path / lib.__name__

        class Export(lib.ExportCallBack):
            FILE_SIZE_CUTOFF = 5000

        # PyElastica reads the bound from the class
        bound, lib.ExportCallBack.FILE_SIZE_CUTOFF = lib.ExportCallBack.FILE_SIZE_CUTOFF, 5000
        sim.append(rod)
        sim.collect_diagnostics(rod).using(Export, 10, "rod", str(folder), "npz")
        sim.finalize()
        lib.integrate(lib.PositionVerlet(), sim, 100 * DT, 100, progress_bar=False)
        sim.close()
        lib.ExportCallBack.FILE_SIZE_CUTOFF = bound
        files.append(numbered(folder))
    assert len(files[0]) > 1 and files[0] == files[1]


def test_there_is_no_last_path_before_the_first_file(tmp_path):
    for lib in (theirs, ours):
        assert lib.ExportCallBack(10, "rod", str(tmp_path / lib.__name__), "npz").get_last_saved_path() is None


# arguments


@pytest.mark.parametrize("direction", [Z, X + Y, np.array([1e-3, -2.0, 0.4])])
def test_a_normal_along_the_axis_of_a_cylinder_is_replaced(direction):
    with pytest.warns(UserWarning, match="the cosine between them is -1: another perpendicular is used"):
        cylinder = ours.Cylinder(np.zeros(3), direction, -direction, 0.3, 0.01, 1000.0)
    Q = cylinder.director_collection[..., 0]
    assert np.allclose(Q @ Q.T, np.eye(3), atol=1e-14) and np.linalg.det(Q) == pytest.approx(1.0)
    assert np.allclose(Q[2], direction / np.linalg.norm(direction))


def test_an_oblique_normal_of_a_cylinder_is_made_perpendicular():
    with pytest.warns(UserWarning, match="its perpendicular part is used"):
        cylinder = ours.Cylinder(np.zeros(3), Z, X + Z, 0.3, 0.01, 1000.0)
    assert np.allclose(cylinder.director_collection[..., 0], [X, Y, Z], atol=1e-14)


def test_shear_correction_of_0_2():
    rod = make_rod(ours, alpha_c=4.0 / 3.0, shear_modulus=4e4)
    assert rod.shear_matrix[0, 0, 0] == pytest.approx(4.0 / 3.0 * 4e4 * np.pi * 0.01**2)
    assert rod.shear_matrix[2, 2, 0] == make_rod(ours).shear_matrix[2, 2, 0]
    with pytest.raises(ValueError, match=r"alpha_c must be a positive number, not 0.0"):
        make_rod(ours, alpha_c=0.0)


def test_rods_ignore_unknown_keywords_with_a_warning():
    make_rod(theirs, shear_moduli=4e4)
    with pytest.warns(UserWarning, match=r"straight_rod ignores the unknown keyword shear_moduli; did you mean shear_"):
        make_rod(ours, shear_moduli=4e4)
    with pytest.warns(
        UserWarning, match=r"ring_rod ignores the unknown keyword colour; known keywords: n_elements, ring_"
    ):
        ours.CosseratRod.ring_rod(8, np.ones(3), Z, Y, colour="red", **ROD)


FEATURES = {
    "damper": ("dampen", "AnalyticalLinearDamper", dict(uniform_damping_constant=1.0), "time_stap", "time_step"),
    "filter": ("dampen", "LaplaceDissipationFilter", dict(filter_order=2), "filter_odrer", "filter_order"),
    "constraint": (
        "constrain",
        "OneEndFixedBC",
        dict(constrained_position_idx=(0,), constrained_director_idx=(0,)),
        "constrained_position_index",
        "constrained_position_idx",
    ),
}


@pytest.mark.parametrize(("method", "cls", "given", "wrong", "right"), FEATURES.values(), ids=FEATURES.keys())
def test_features_ignore_unknown_keywords_with_a_warning(method, cls, given, wrong, right):
    for lib in (theirs, ours):
        sim, rod = simulator(lib), make_rod(lib)
        sim.append(rod)
        more = dict(time_step=DT) if lib is theirs and cls == "AnalyticalLinearDamper" else {}
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            getattr(sim, method)(rod).using(getattr(lib, cls), **given, **more, **{wrong: 1})
        said = [str(each.message) for each in caught]
        assert said == ([f"{cls} ignores the unknown keyword {wrong}; did you mean {right}?"] if lib is ours else [])
        sim.finalize()


def test_features_without_unknown_keywords_do_not_warn():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for method, cls, given, _, _ in FEATURES.values():
            sim = simulator(ours)
            sim.append(make_rod(ours))
            getattr(sim, method)(sim[0]).using(getattr(ours, cls), **given)
            sim.finalize()


@pytest.mark.parametrize("name", ["GravityForces", "EndpointForces", "FreeJoint", "HingeJoint", "MyCallBack"])
def test_features_reject_unknown_keywords_if_pyelastica_does(name):
    given = {
        "GravityForces": ("add_forcing_to", {}),
        "EndpointForces": ("add_forcing_to", dict(start_force=X, end_force=X, ramp_up_time=1.0)),
        "FreeJoint": ("connect", dict(k=1.0, nu=0.0)),
        "HingeJoint": ("connect", dict(k=1.0, nu=0.0, kt=1.0, normal_direction=X)),
        "MyCallBack": ("collect_diagnostics", dict(step_skip=1, callback_params={})),
    }[name]
    for lib in (theirs, ours):
        sim, rods = simulator(lib), (make_rod(lib), make_rod(lib))
        sim.extend(rods)
        declare = getattr(sim, given[0])
        declared = declare(*rods, 0, 0) if given[0] == "connect" else declare(rods[0])
        declared.using(getattr(lib, name), **given[1], colour="red")
        with pytest.raises(TypeError, match=r"colour|Unable to construct"):
            sim.finalize()
