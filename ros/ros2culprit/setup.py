from setuptools import find_packages
from setuptools import setup

package_name = 'ros2culprit'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='The culprit developers',
    maintainer_email='maintainers@example.org',
    description='ros2 culprit: asks the culprit program what is wrong with the robot.',
    license='Apache-2.0',
    extras_require={'test': ['pytest']},
    entry_points={
        'ros2cli.command': [
            'culprit = ros2culprit.command.culprit:CulpritCommand',
        ],
        'ros2cli.extension_point': [
            'ros2culprit.verb = ros2culprit.verb:VerbExtension',
        ],
        'ros2culprit.verb': [
            'doctor = ros2culprit.verb.handed_on:DoctorVerb',
            'explain = ros2culprit.verb.handed_on:ExplainVerb',
            'status = ros2culprit.verb.handed_on:StatusVerb',
        ],
    },
)
