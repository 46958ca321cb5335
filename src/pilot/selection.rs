//! An algorithm with the groups of strategies that it uses: what can be picked, and what a user
//! can name.

use crate::error::{Error, Result};
use crate::integrator::Integrator;
use crate::path::{Groups, Strategies};

/// What stands between an algorithm and its groups.
const GROUPS: &str = " --groups ";

/// An algorithm and its groups of strategies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Selection {
    /// The algorithm.
    pub integrator: Integrator,
    /// The groups, where not all that the algorithm stands for are used.
    pub groups: Option<Groups>,
}

impl Selection {
    /// An algorithm with all that it stands for.
    pub const fn whole(integrator: Integrator) -> Self {
        Self { integrator, groups: None }
    }

    /// Bidirectional path tracing with some of its groups; by its own name where these have one.
    pub fn of_groups(groups: Groups) -> Self {
        match groups {
            Groups::PATH => Self::whole(Integrator::Path),
            Groups::LIGHT => Self::whole(Integrator::Light),
            Groups::ALL => Self::whole(Integrator::Bdpt),
            _ => Self { integrator: Integrator::Bdpt, groups: Some(groups) },
        }
    }

    /// The strategies that it stands for, before a plan leaves out what a scene does not need.
    pub fn strategies(self) -> Strategies {
        self.groups.map_or_else(|| self.integrator.strategies(), Groups::strategies)
    }

    /// The selection that is printed as a text, as on the command line: `bdpt --groups path,splats`.
    ///
    /// # Errors
    /// Where no algorithm has the name, or there is no such group.
    pub fn named(text: &str) -> Result<Self> {
        let (name, groups) =
            text.split_once(GROUPS).map_or((text, None), |(name, groups)| (name, Some(groups)));
        let integrator = Integrator::named(name).ok_or_else(|| {
            Error::unknown_name("integrator", name, Integrator::ALL.iter().map(|known| known.name()))
        })?;
        Ok(Self { integrator, groups: groups.map(Groups::named).transpose()? })
    }
}

impl std::fmt::Display for Selection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.integrator.name())?;
        self.groups.map_or(Ok(()), |groups| write!(f, "{GROUPS}{groups}"))
    }
}

impl serde::Serialize for Selection {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selections_are_named_as_they_are_printed() {
        for name in ["path", "light", "bdpt", "mlt", "bdpt --groups path,splats", "bdpt --groups path,joins"]
        {
            let selection = Selection::named(name).expect("known");
            assert_eq!(selection.to_string(), name);
        }
        assert!(Selection::named("bdtp").is_err() && Selection::named("bdpt --groups path,x").is_err());
    }
}
