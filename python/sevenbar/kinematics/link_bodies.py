"""The bodies of links, one each."""
from sevenbar.forces.bodies import as_one
from sevenbar.text.units import LENGTHS
def resolved(linkage, bodies):
    return {link: as_one(own, LENGTHS[linkage.length_unit]) for link, own in bodies.items()}
