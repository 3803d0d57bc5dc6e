C     Uniaxial springs on the normal strains, written for the tests, that misbehave on demand.
C     PROPS: mode, stiffness (MPa), a parameter of the mode. STATEV(1) counts calls that were kept.
C       1  PNEWDT = 0.3 while DTIME exceeds the parameter
C       2  NaN in the stress from the total time of the parameter on
C       3  PNEWDT = parameter at every call
C       4  error message and stop from the total time of the parameter on
C       5  STATEV(2-6) = what was passed of CMNAME's length, its first character, KSTEP, KINC, TEMP
C       6  a warning of 300 characters at every call
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'header.inc'
      CHARACTER*(*) CMNAME
      INTEGER I,MODE,MESSAGES,STOPPED
      CHARACTER*300 TEXT
      COMMON /STANDIN/ MESSAGES,STOPPED,TEXT
      MODE = NINT(PROPS(1))
      DDSDDE = 0.D0
      DO I = 1, NTENS
        STRESS(I) = PROPS(2)*(STRAN(I) + DSTRAN(I))
        DDSDDE(I,I) = PROPS(2)
      END DO
      STATEV(1) = STATEV(1) + 1.D0
      IF (MODE .EQ. 1 .AND. DTIME .GT. PROPS(3)) PNEWDT = 0.3D0
      IF (MODE .EQ. 2 .AND. TIME(2) + DTIME .GE. PROPS(3))
     1  STRESS(3) = SQRT(-1.D0 - STATEV(1)**2)
      IF (MODE .EQ. 3) PNEWDT = PROPS(3)
      IF (MODE .EQ. 4 .AND. TIME(2) + DTIME .GE. PROPS(3)) THEN
        MESSAGES = MESSAGES + 1
        STOPPED = 1
        TEXT = 'element 1 point 1: the spring is broken'
      END IF
      IF (MODE .EQ. 5) THEN
        STATEV(2) = LEN(CMNAME)
        STATEV(3) = ICHAR(CMNAME(1:1))
        STATEV(4) = JSTEP(1)
        STATEV(5) = KINC
        STATEV(6) = TEMP
      END IF
      IF (MODE .EQ. 6) THEN
        MESSAGES = MESSAGES + 1
        TEXT = REPEAT('w', 300)
      END IF
      END

C     The accessor of messages as the stand-ins of Abaqus's utility routines offer it.
      FUNCTION TAKE(STOP_ASKED, TEXT_OUT, LENGTH)
     1  BIND(C, NAME='plyflow_standin_take') RESULT(TAKEN)
      USE, INTRINSIC :: ISO_C_BINDING
      IMPLICIT NONE
      INTEGER(C_INT) :: STOP_ASKED
      CHARACTER(KIND=C_CHAR) :: TEXT_OUT(*)
      INTEGER(C_INT), VALUE :: LENGTH
      INTEGER(C_INT) :: TAKEN
      INTEGER I,MESSAGES,STOPPED
      CHARACTER*300 TEXT
      COMMON /STANDIN/ MESSAGES,STOPPED,TEXT
      TAKEN = MESSAGES
      STOP_ASKED = STOPPED
      DO I = 1, MIN(LENGTH - 1, LEN_TRIM(TEXT))
        TEXT_OUT(I) = TEXT(I:I)
      END DO
      TEXT_OUT(MIN(LENGTH - 1, LEN_TRIM(TEXT)) + 1) = C_NULL_CHAR
      MESSAGES = 0
      STOPPED = 0
      END
