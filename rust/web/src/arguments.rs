//! The arguments of a call, by name.

use cardan::{
    Axes, Batch, Drivelines, End, Error, Geometry, Load, Output, Result, Rows, Source,
    check_bearings, check_length,
};

use crate::MOST;
use crate::table::{Field, Function};

/// The arguments of a function.
pub(crate) struct Arguments<'a> {
    fields: Vec<Field>,
    values: Vec<&'a [f64]>,
}

/// Drivelines of a call, all of whose arrays fit together.
pub(crate) struct Lines<'a> {
    pub(crate) joints: usize,
    pub(crate) shape: [usize; 1],
    pub(crate) arrays: Drivelines<'a>,
    pub(crate) batch: Batch,
}

/// The load of a call, one for each driveline.
pub(crate) struct LoadOf<'a> {
    pub(crate) end: End,
    pub(crate) torque: &'a [f64],
    pub(crate) speed: &'a [f64],
    pub(crate) acceleration: &'a [f64],
    pub(crate) inertias: Vec<(usize, &'a [f64])>,
}

/// Outputs to compute for drivelines.
pub(crate) struct RequestOf {
    pub(crate) outputs: Vec<Output>,
    pub(crate) shafts: Vec<usize>,
    pub(crate) joints: Vec<usize>,
    pub(crate) axes: Axes,
}

impl<'a> Arguments<'a> {
    /// Reads what the room holds.
    pub(crate) fn read(function: &Function, mut flat: &'a [f64]) -> Result<Self> {
        let fields = function.arguments.concat();
        let mut values = Vec::with_capacity(fields.len());
        for field in &fields {
            let (count, rest) = flat.split_first().map_or((0.0, flat), |(&n, rest)| (n, rest));
            if !(count >= 0.0 && count <= rest.len() as f64) {
                let problem = format!("is said to have {count} values; {} follow", rest.len());
                return Err(Error::new(field.name, &[], problem));
            }
            let (own, rest) = rest.split_at(count as usize);
            values.push(own);
            flat = rest;
        }
        Ok(Self { fields, values })
    }

    fn takes(&self, name: &str) -> bool {
        self.fields.iter().any(|field| field.name == name)
    }

    /// The values of an argument.
    ///
    /// # Panics
    /// If the function has no such argument.
    pub(crate) fn of(&self, name: &str) -> &'a [f64] {
        let place = self.fields.iter().position(|field| field.name == name);
        self.values[place.unwrap_or_else(|| panic!("there is no argument {name}"))]
    }

    /// The same, each of which must be finite.
    pub(crate) fn finite(&self, name: &'static str) -> Result<&'a [f64]> {
        let values = self.of(name);
        check(name, values, "it must be finite", f64::is_finite)?;
        Ok(values)
    }

    /// One number.
    pub(crate) fn number(&self, name: &'static str) -> Result<f64> {
        let values = self.of(name);
        match values {
            [value] => Ok(*value),
            [] => Err(Error::new(name, &[], "is missing; it is one number")),
            _ => Err(Error::new(name, &[], format!("has {} values; it has one", values.len()))),
        }
    }

    /// One number, if it is given.
    pub(crate) fn maybe(&self, name: &'static str) -> Result<Option<f64>> {
        if self.of(name).is_empty() { Ok(None) } else { self.number(name).map(Some) }
    }

    /// One flag, not set if it is not given.
    pub(crate) fn flag(&self, name: &'static str) -> Result<bool> {
        Ok(self.maybe(name)?.is_some_and(|value| value != 0.0))
    }

    /// Whole numbers from 0 on.
    pub(crate) fn counts(&self, name: &'static str) -> Result<Vec<usize>> {
        let values = self.of(name);
        let whole = |x: f64| x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0;
        check(name, values, "it must be a whole number from 0 on", whole)?;
        Ok(values.iter().map(|&value| value as usize).collect())
    }

    /// One whole number from 0 on.
    pub(crate) fn count(&self, name: &'static str) -> Result<usize> {
        self.number(name)?;
        Ok(self.counts(name)?[0])
    }

    /// Members of a list by their places in it.
    pub(crate) fn members<T: Copy>(&self, name: &'static str, all: &[T]) -> Result<Vec<T>> {
        let places = self.counts(name)?;
        let member = |(i, &place): (usize, &usize)| {
            let problem = || format!("is {place}; there are {}", all.len());
            all.get(place).copied().ok_or_else(|| Error::new(name, &[i], problem()))
        };
        places.iter().enumerate().map(member).collect()
    }

    /// One member; the first if none is given.
    pub(crate) fn member<T: Copy>(&self, name: &'static str, all: &[T]) -> Result<T> {
        Ok(self.members(name, all)?.first().copied().unwrap_or(all[0]))
    }

    /// Bends, twists and phases by these names, which obey the rules of drivelines from bends.
    pub(crate) fn chains(&self, names: [&'static str; 3]) -> Result<(usize, [&'a [f64]; 3])> {
        let joints = self.count("joints")?;
        let (arrays, between) = (names.map(|name| self.of(name)), joints.saturating_sub(1));
        let count = arrays[0].len().checked_div(joints).unwrap_or(0);
        let each = [joints, between, between];
        for i in 0..3 {
            check_length(names[i], arrays[i].len(), count, each[i])?;
        }
        for line in 0..count.max(1) {
            let own = |i: usize| arrays[i].get(line * each[i]..(line + 1) * each[i]);
            let [bends, twists, phases] = [0, 1, 2].map(|i| own(i).unwrap_or_default());
            let at: &[usize] = if count > 0 { &[line] } else { &[] };
            Geometry::from_bends(bends, twists, phases).map_err(|error| error.within(at))?;
        }
        Ok((joints, arrays))
    }

    /// Drivelines by the names of their arrays. What the function does not take is empty.
    pub(crate) fn drivelines(&self, names: [&'static str; 7]) -> Result<Lines<'a>> {
        let [bends, twists, phases, ..] = names;
        let (joints, [bends, twists, phases]) = self.chains([bends, twists, phases])?;
        let mut arrays = [bends, twists, phases, &[], &[], &[], &[], &[]];
        for (array, name) in
            arrays.iter_mut().zip(names).skip(3).filter(|(_, name)| self.takes(name))
        {
            *array = self.finite(name)?;
        }
        let arrays = Drivelines::from_arrays(arrays);
        let shape = [bends.len() / joints];
        let is_mounted = !(arrays.lengths.is_empty() && arrays.positions.is_empty());
        let bearings = if is_mounted { self.counts("bearings")? } else { vec![] };
        let batch = Batch::new(joints, &shape, &bearings, &arrays)?;
        if is_mounted {
            check_bearings(joints, &shape, &bearings, arrays.lengths, arrays.positions)?;
        }
        Ok(Lines { joints, shape, arrays, batch })
    }

    /// Drivelines by the usual names.
    pub(crate) fn lines(&self) -> Result<Lines<'a>> {
        let [names @ .., _] = Drivelines::NAMES;
        self.drivelines(names)
    }

    /// The load of so many drivelines, if there is one.
    pub(crate) fn load(
        &self,
        count: usize,
        names: [&'static str; 4],
    ) -> Result<Option<LoadOf<'a>>> {
        let [torque, speed, acceleration, inertias] = names;
        if self.of(torque).is_empty() {
            return Ok(None);
        }
        let one_each = |name| {
            let values = self.finite(name)?;
            check_length(name, values.len(), count, 1)?;
            Ok(values)
        };
        let (shafts, each) = (self.counts("inertia_shafts")?, self.finite(inertias)?);
        check_length(inertias, each.len(), shafts.len(), count)?;
        check(inertias, each, "it must not be negative", |x| x >= 0.0)?;
        Ok(Some(LoadOf {
            end: self.member("end", &[End::Drive, End::Output])?,
            torque: one_each(torque)?,
            speed: one_each(speed)?,
            acceleration: one_each(acceleration)?,
            inertias: shafts.into_iter().zip(each.chunks(count.max(1))).collect(),
        }))
    }

    /// The load by its usual names.
    pub(crate) fn usual_load(&self, count: usize) -> Result<Option<LoadOf<'a>>> {
        self.load(count, ["torque", "speed", "acceleration", "inertias"])
    }

    /// The outputs to compute.
    pub(crate) fn request(&self) -> Result<RequestOf> {
        Ok(RequestOf {
            outputs: self.members("outputs", &Output::ALL)?,
            shafts: self.counts("of_shafts")?,
            joints: self.counts("of_joints")?,
            axes: self.member("axes", &[Axes::Space, Axes::Shaft])?,
        })
    }
}

impl Lines<'_> {
    /// The number of drivelines.
    pub(crate) fn count(&self) -> usize {
        self.shape[0]
    }

    /// The drivelines and their loads, one row each.
    pub(crate) fn rows<'b>(&'b self, load: Option<&LoadOf<'b>>) -> Rows<'b> {
        Rows {
            shape: &self.shape,
            lines: self.arrays,
            line_strides: &[1],
            load: load.map(|load| load.source(&[1])),
        }
    }
}

impl<'a> LoadOf<'a> {
    /// The load with these strides.
    pub(crate) fn source(&self, strides: &'a [usize]) -> Load<'a> {
        let of = |data| Source { data, strides };
        Load {
            torque: of(self.torque),
            speed: of(self.speed),
            acceleration: of(self.acceleration),
            inertias: self.inertias.iter().map(|&(shaft, each)| (shaft, of(each))).collect(),
        }
    }

    /// The shafts with an inertia.
    pub(crate) fn shafts(&self) -> Vec<usize> {
        self.inertias.iter().map(|inertia| inertia.0).collect()
    }
}

/// Refuses values that break a rule.
pub(crate) fn check(
    name: &'static str,
    values: &[f64],
    rule: &'static str,
    keeps: impl Fn(f64) -> bool,
) -> Result<()> {
    let broken = values.iter().position(|&value| !keeps(value));
    broken.map_or(Ok(()), |i| {
        Err(Error::of_value(name, &[i], values[i], cardan::Rule::new("", rule)))
    })
}

/// Refuses more results than a page can use.
pub(crate) fn check_results(argument: &'static str, factors: &[usize]) -> Result<usize> {
    let total = factors.iter().try_fold(1_usize, |total, &factor| total.checked_mul(factor));
    total.filter(|&total| total <= MOST).ok_or_else(|| {
        let product: Vec<String> = factors.iter().map(ToString::to_string).collect();
        let problem = format!("need {} results; at most {MOST} are possible", product.join(" x "));
        Error::new(argument, &[], problem)
    })
}
